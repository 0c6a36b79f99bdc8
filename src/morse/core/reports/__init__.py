"""What users read: the log, descriptions of errors, hints."""
