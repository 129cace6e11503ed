"""Time: the ruler, the spans, and the bar that shows where in the take the view is."""
