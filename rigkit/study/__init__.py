"""Studies: any command line over machines, seeds and settings, on every core or a cluster; results as Parquet."""
