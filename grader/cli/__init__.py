"""The command line: `./course VERB`, its arguments and what each verb does."""
