"""What the user can do: the table of it, the menus made from that, and who carries it out (`retarget` its own)."""
