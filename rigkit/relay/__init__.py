"""A relay in an amplifier's supply that closes while frames on a CAN bus say that all is well."""
