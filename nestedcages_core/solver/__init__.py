"""Solvers: of objectives, by steps that lower them, and of quadratic programs."""
