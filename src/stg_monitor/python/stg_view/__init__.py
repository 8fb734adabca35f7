"""Recordings of runs, and the page that shows them: in a browser, live, or as one HTML file."""
