"""Targets, their configuration by Kconfig, and the build."""
