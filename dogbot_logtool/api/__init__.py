"""What `import dogbot_logtool` offers; loaded when a name of it is used."""
