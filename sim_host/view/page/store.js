// The rows of the newest ticks, a ring for each signal.
export const RING = 65536;

export class Store {
  constructor(signals) {
    this.signals = signals;
    this.place = new Map(signals.map((one, i) => [one.name, i]));
    this.columns = signals.map(() => new Float32Array(RING).fill(NaN));
    this.stats = { ticks: 0, lost: 0, repeated: 0 };
    this.clear(0);
  }

  clear(walk) {
    this.walk = walk;
    this.first = this.next = -1; // ticks first .. next - 1 are there
    for (const column of this.columns) column.fill(NaN);
  }

  // A binary message of the server (hub.py: rows_message). Returns {first, rows, stamp}, or null for an older walk's.
  take(buffer) {
    const view = new DataView(buffer);
    const first = view.getUint32(4, true), rows = view.getUint16(8, true), columns = view.getUint16(10, true);
    const walk = view.getUint32(12, true), stamp = view.getFloat64(16, true);
    if (columns !== this.columns.length || walk !== this.walk) return null;
    const data = new Float32Array(buffer, 24, rows * columns);
    if (this.next < 0) this.first = this.next = first;
    if (first > this.next) {
      this.stats.lost += first - this.next;
      if (first - this.next > RING) this.first = this.next = first;
      for (let t = this.next; t < first; t++) for (const column of this.columns) column[t % RING] = NaN;
    }
    for (let c = 0; c < columns; c++) {
      const column = this.columns[c];
      for (let r = 0, t = first, at = c * rows; r < rows; r++, t++, at++) column[t % RING] = data[at];
    }
    if (first + rows > this.next) {
      this.stats.ticks += first + rows - Math.max(first, this.next);
      this.next = first + rows;
    }
    this.first = Math.max(Math.min(this.first, first), this.next - RING);
    return { first, rows, stamp };
  }

  has(tick) { return tick >= this.first && tick < this.next; }

  value(name, tick) {
    const place = this.place.get(name);
    return this.has(tick) && place !== undefined ? this.columns[place][tick % RING] : NaN;
  }

  // Ticks from .. to - 1 of some signals, thinned to about `points` by least and greatest of each bucket.
  window(names, from, to, points, tickS) {
    const columns = names.map((name) => this.columns[this.place.get(name)]);
    from = Math.max(from, this.first, 0);
    to = Math.min(to, this.next);
    const count = Math.max(to - from, 0), bucket = Math.max(1, Math.ceil(count / points));
    if (bucket === 1) {
      const x = new Float64Array(count);
      for (let i = 0; i < count; i++) x[i] = (from + i) * tickS;
      return [x, ...columns.map((column) => {
        const y = new Array(count);
        for (let i = 0; i < count; i++) { const v = column[(from + i) % RING]; y[i] = v === v ? v : null; }
        return y;
      })];
    }
    const begin = Math.floor(from / bucket) * bucket, buckets = Math.max(0, Math.ceil((to - begin) / bucket));
    const x = new Float64Array(2 * buckets);
    for (let b = 0; b < buckets; b++) {
      x[2 * b] = (begin + b * bucket) * tickS;
      x[2 * b + 1] = (begin + (b + 0.5) * bucket) * tickS;
    }
    return [x, ...columns.map((column) => thin(column, begin, from, to, bucket, buckets))];
  }
}

function thin(column, begin, from, to, bucket, buckets) {
  const y = new Array(2 * buckets);
  for (let b = 0; b < buckets; b++) {
    let low = Infinity, high = -Infinity, lowAt = 0, highAt = 0;
    const start = Math.max(begin + b * bucket, from), end = Math.min(begin + (b + 1) * bucket, to);
    for (let t = start; t < end; t++) {
      const v = column[t % RING];
      if (v < low) { low = v; lowAt = t; }
      if (v > high) { high = v; highAt = t; }
    }
    const none = low === Infinity;
    y[2 * b] = none ? null : lowAt <= highAt ? low : high;
    y[2 * b + 1] = none ? null : lowAt <= highAt ? high : low;
  }
  return y;
}
