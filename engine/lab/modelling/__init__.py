"""The program that models the bundled head: clay, skin, parts and the 52 shapes, from numbers alone.

Inside, lengths are centimetres and x is the character's left, y up, z forward; y = 0 at the pupils, z = 0 near the
ear canals. The file it writes is in millimetres.
"""
