"use strict";
// A click on a heading sorts the rows by its column: numbers by size, words by the alphabet.
(() => {
  const body = document.querySelector("tbody");
  const number = (text) => { const value = parseFloat(text.replace(/[,%]/g, "")); return Number.isNaN(value) ? null : value; };
  function order(column, isWords, sign) {
    const value = (row) => (row.cells[column] ? row.cells[column].innerText.trim() : "");
    return (one, other) => {
      const [first, second] = [value(one), value(other)];
      if (isWords) return sign * first.localeCompare(second);
      const [low, high] = [number(first), number(second)];
      // Rows without a number come last, whatever the order.
      if (low === null || high === null) return (low === null) - (high === null);
      return sign * (low - high);
    };
  }
  for (const button of document.querySelectorAll("thead button")) {
    const heading = button.closest("th");
    button.addEventListener("click", () => {
      const sign = heading.getAttribute("aria-sort") === "ascending" ? -1 : 1;
      for (const other of document.querySelectorAll("thead th")) other.removeAttribute("aria-sort");
      heading.setAttribute("aria-sort", sign > 0 ? "ascending" : "descending");
      const rows = [...body.rows].sort(order(heading.cellIndex, heading.classList.contains("words"), sign));
      body.append(...rows);
    });
  }
})();
