"""Words that all storeys share."""
