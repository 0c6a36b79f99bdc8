"""What pages are sent beside the poses."""
