function startReplay() {}
