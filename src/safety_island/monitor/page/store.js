// SPDX-License-Identifier: Apache-2.0
// The numbers of the last minutes: one array of doubles for each field, oldest first.

const ROOM = 1 << 17; // rows; half of them are dropped when it is full

export class Store {
  constructor(fields, seconds) {
    this.fields = fields;
    this.seconds = seconds;
    this.columns = Object.fromEntries(fields.map((name) => [name, new Float64Array(ROOM)]));
    this.count = 0;
  }

  add(row) {
    if (this.count === ROOM) this.drop(ROOM / 2);
    for (let i = 0; i < row.length; i++) {
      this.columns[this.fields[i]][this.count] = row[i] ?? NaN;
    }
    this.count++;
  }

  drop(rows) {
    for (const column of Object.values(this.columns)) column.copyWithin(0, rows, this.count);
    this.count -= rows;
  }

  get newest() {
    return this.count ? this.columns.t[this.count - 1] : NaN;
  }

  get oldest() {
    const from = this.first(this.newest - this.seconds);
    return this.count ? this.columns.t[from] : NaN;
  }

  // Index of the first row at or after a time.
  first(time) {
    let low = 0, high = this.count;
    const t = this.columns.t;
    while (low < high) {
      const middle = (low + high) >> 1;
      if (t[middle] < time) low = middle + 1;
      else high = middle;
    }
    return low;
  }

  value(name, index) {
    return index >= 0 && index < this.count ? this.columns[name][index] : NaN;
  }

  // The rows of a time span as lists for a plot: t, then each name; null where there is none.
  // With more rows than `most` the least and the greatest of each bundle stand for it. A gap of
  // more than `gap` seconds between two rows is shown as one.
  span(names, from, to, most, gap) {
    const begin = Math.max(0, this.first(from) - 1), end = Math.min(this.count, this.first(to) + 1);
    const bundle = Math.max(1, Math.ceil((end - begin) / most));
    const found = [[], ...names.map(() => [])];
    for (let i = begin; i < end; i += bundle) {
      const stop = Math.min(i + bundle, end);
      const t = this.columns.t[i];
      if (i > begin && t - this.columns.t[i - 1] > gap) push(found, t - gap / 2, null, names.length);
      found[0].push(t);
      if (bundle > 1) found[0].push((t + this.columns.t[stop - 1]) / 2 + 1e-4);
      names.forEach((name, k) => {
        const column = this.columns[name];
        if (bundle === 1) {
          found[k + 1].push(finite(column[i]));
          return;
        }
        let least = Infinity, greatest = -Infinity;
        for (let j = i; j < stop; j++) {
          if (column[j] < least) least = column[j];
          if (column[j] > greatest) greatest = column[j];
        }
        found[k + 1].push(finite(least), finite(greatest));
      });
    }
    return found;
  }
}

function finite(value) {
  return Number.isFinite(value) ? value : null;
}

function push(lists, t, value, count) {
  lists[0].push(t);
  for (let k = 1; k <= count; k++) lists[k].push(value);
}
