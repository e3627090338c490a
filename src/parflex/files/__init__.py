"""Robot files: TOML with units, read with line numbers, written whole."""
