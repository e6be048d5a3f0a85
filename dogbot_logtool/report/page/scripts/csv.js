// What a figure or a table shows, as a CSV file.

const plainText = (html) => new DOMParser().parseFromString(String(html ?? ""), "text/html").documentElement.textContent;
const cell = (value) => {
  const text = typeof value === "number" ? (Number.isFinite(value) ? String(Number(value.toPrecision(9))) : "") : String(value ?? "");
  return /[",\r\n]/.test(text) ? `"${text.replaceAll('"', '""')}"` : text;
};
const lines = (rows) => rows.map((row) => row.map(cell).join(",")).join("\r\n") + "\r\n";

// A row a point, or a bar with its start and end.
function figureRows(plot) {
  const isBars = plot.data.some((trace) => trace.type === "bar");
  const time = plot.over_time ? "time_s" : "x";
  const rows = [isBars ? ["series", "start_s", "end_s"] : ["series", time, "value"]];
  for (const trace of plot.data) {
    if (trace.fill || trace.mode === "text" || !trace.x) continue;
    const name = plainText(trace.name);
    for (let point = 0; point < trace.x.length; point += 1) {
      if (isBars) rows.push([name, trace.base[point], trace.base[point] + trace.x[point]]);
      else if (!Number.isNaN(trace.y[point])) rows.push([name, trace.x[point], trace.y[point]]);
    }
  }
  return rows;
}
function tableRows(table) {
  const text = (node) => (node.dataset.value ?? node.innerText).replace(/[▲▼△▽■□◆◇●○✚✛]/gu, "").trim();
  return [...table.rows].map((row) => [...row.cells].map(text));
}
function save(name, rows) {
  const link = document.createElement("a");
  link.href = URL.createObjectURL(new Blob([lines(rows)], { type: "text/csv" }));
  link.download = `${document.querySelector("h1").textContent}.${name}.csv`;
  link.click();
  setTimeout(() => URL.revokeObjectURL(link.href), 10000);
}
function offerTables() {
  for (const button of document.querySelectorAll("button[data-csv]")) {
    const name = button.dataset.csv;
    const plot = plots.find((each) => each.name === name);
    const table = button.closest("section")?.querySelector("table");
    button.addEventListener("click", () => save(name, plot ? figureRows(plot) : tableRows(table)));
  }
}
