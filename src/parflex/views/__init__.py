"""Pictures, the viewer and the report."""
