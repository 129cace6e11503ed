"""Sound and reference video that go with the take, and the clock that both and the playhead follow."""
