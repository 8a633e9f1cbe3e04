"""The toroid in steel: by robot alone, with a tracker, with the stage and mid-ranging."""
