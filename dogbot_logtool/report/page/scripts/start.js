document.getElementById("alone")?.remove();
offerTables();
if (document.getElementById("replay")) startReplay();
drawFigures().then(() => { document.documentElement.dataset.drawn = "yes"; });
