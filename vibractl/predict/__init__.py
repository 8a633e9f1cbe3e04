"""What a run will need and how it may go, before anything is emitted."""
