"""The piezo stage follows a reference: its run, recorded, measured, reported and replayed."""
