"""Each method against its baselines: one package per method, `tables.TABLES` lists what each of them measures."""
