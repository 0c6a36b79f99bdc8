"""The MCAP container (https://mcap.dev/spec), as far as recordings use it: chunks, indexes, attachments, metadata."""
