"""The face: camera, lighting, the one renderer and the thread that owns it, and the panel that shows the picture."""
