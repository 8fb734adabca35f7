"""Recordings of runs, and the page that shows them: live in a browser, or as one HTML file."""
