"""Commands of stagectl that are of no one experiment."""
