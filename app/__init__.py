"""The desktop program and its command line; imports the engine, never the reverse."""
