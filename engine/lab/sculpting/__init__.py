"""The second bundled head, sculpted from numbers: proportions and motions fitted to what was measured on scanned people.

Its clay is one signed distance whose solids lie at measured places; its shapes are the measured paths of some seventy
handles, interpolated over a skin of its own. No vertex of another mesh is taken over.
"""
