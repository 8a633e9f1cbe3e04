"""Model files, and what they were measured on."""
