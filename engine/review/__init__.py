"""Reviewing a take against another: where they differ, by how much, who changed it, and a report of it.

`align` puts two takes on one clock, `changes` lists where they differ, `report` writes it down as HTML. Nothing here
draws: pictures come from whoever calls.
"""
