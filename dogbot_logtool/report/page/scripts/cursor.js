// What all parts of the page share: data, and one cursor in time.

const read = (id) => JSON.parse(document.getElementById(id).textContent);
const ARRAYS = { f8: Float64Array, f4: Float32Array, i4: Int32Array, i2: Int16Array, i1: Int8Array };

// Numbers of an array that Python packed, as they are in memory; rows of several follow each other.
function unpack(packed) {
  const bytes = Uint8Array.from(atob(packed.bdata), (letter) => letter.charCodeAt(0));
  const numbers = new ARRAYS[packed.dtype](bytes.buffer);
  if (packed.step === undefined) return numbers;
  return Float64Array.from(numbers, (level) => level === -32768 ? NaN : (level + 32767) * packed.step + packed.lowest);
}
function unpackAll(value) {
  if (value === null || typeof value !== "object") return value;
  if (value.bdata !== undefined) {
    const flat = unpack(value);
    if (!value.shape) return flat;
    const width = Number(value.shape.split(",")[1]);
    return Array.from({ length: flat.length / width }, (_, row) => Array.from(flat.subarray(row * width, (row + 1) * width)));
  }
  for (const key of Object.keys(value)) value[key] = unpackAll(value[key]);
  return value;
}

// Index of the last of some increasing numbers that is not above a value; -1 before the first.
function lastUpTo(numbers, value) {
  let low = 0, high = numbers.length;
  while (low < high) {
    const middle = (low + high) >> 1;
    if (numbers[middle] <= value) low = middle + 1; else high = middle;
  }
  return low - 1;
}

const cursor = {
  time: null,
  listeners: [],
  set(time, from) {
    this.time = time;
    for (const each of this.listeners) each(time, from);
  },
};

// Called when the page's colours have changed.
const onColours = [];
const colour = (name) => getComputedStyle(document.documentElement).getPropertyValue(name).trim();
