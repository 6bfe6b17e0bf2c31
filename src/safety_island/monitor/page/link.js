// SPDX-License-Identifier: Apache-2.0
// The connection to the monitor: kept up, and its loss and return are told.

const WAITS_MS = [250, 500, 1000, 2000];
const SILENT_MS = 5000;

export class Link {
  // take(message) is called for each message, told(state, words) when the connection changes.
  constructor(take, told) {
    this.take = take;
    this.told = told;
    this.token = location.hash.slice(1);
    this.tries = 0;
    this.open();
    setInterval(() => this.watch(), 1000);
  }

  open() {
    const socket = new WebSocket(`ws://${location.host}/data`);
    this.socket = socket;
    this.cameAt = performance.now();
    socket.onopen = () => this.token && socket.send(JSON.stringify({ token: this.token }));
    socket.onmessage = (event) => {
      this.cameAt = performance.now();
      this.tries = 0;
      for (const message of JSON.parse(event.data)) this.take(message);
    };
    socket.onclose = (event) => this.lost(event);
  }

  lost(event) {
    if (event.code === 4401) {
      this.told("lost", "open the address as it was printed: its token is missing or wrong");
      return;
    }
    const wait = WAITS_MS[Math.min(this.tries++, WAITS_MS.length - 1)];
    this.told("lost", "connection lost, trying again");
    setTimeout(() => this.open(), wait);
  }

  // A connection on which nothing comes is as good as lost; closing it starts another.
  watch() {
    if (this.socket.readyState === 1 && performance.now() - this.cameAt > SILENT_MS) this.socket.close();
  }

  press(key) {
    if (this.socket.readyState === 1) this.socket.send(JSON.stringify({ press: key, token: this.token }));
  }
}
