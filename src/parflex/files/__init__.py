"""Robot files and trajectory files: TOML with units, read with line numbers, written whole."""
