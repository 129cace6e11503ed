"""The panel at the right: the tool's settings, the spans, and what the last edit came to."""
