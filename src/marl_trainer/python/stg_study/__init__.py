"""A study: many trainings and evaluations, and the tables and figures from them."""
