"""The command ``island``: one small file for each of its commands."""
