"""Driven robots that glide over level floors without contacts to compute."""
