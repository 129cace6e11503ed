"""The live view of a phone's stream."""
