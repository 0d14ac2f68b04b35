// The web socket, with the token of the printed address, and again and again when it is lost.
export class Link {
  constructor(handlers) {
    this.handlers = handlers;
    const given = location.hash.slice(1);
    const isToken = given.length > 15; // a part of the page has a shorter name
    this.token = isToken ? given : sessionStorage.getItem("afo-token") || given;
    if (isToken) {
      sessionStorage.setItem("afo-token", this.token);
      history.replaceState(null, "", location.pathname); // the token does not stay in the address line
    }
    this.wait = 500;
    this.open();
  }

  open() {
    this.socket = new WebSocket(`${location.protocol === "https:" ? "wss" : "ws"}://${location.host}/live`,
      ["afo.v1", `token.${this.token}`]);
    this.socket.binaryType = "arraybuffer";
    this.socket.onopen = () => { this.wait = 500; };
    this.socket.onmessage = (event) => {
      if (typeof event.data === "string") this.handlers.message(JSON.parse(event.data));
      else this.handlers.rows(event.data);
    };
    this.socket.onclose = () => {
      this.handlers.lost();
      setTimeout(() => this.open(), this.wait);
      this.wait = Math.min(2 * this.wait, 8000);
    };
  }

  ask(what) {
    if (this.socket.readyState !== WebSocket.OPEN) return false;
    this.socket.send(JSON.stringify(what));
    return true;
  }

  // A file of the server, with the token.
  async fetch(path, kind = "blob") {
    const answer = await fetch(path, { headers: { Authorization: `Bearer ${this.token}` } });
    if (!answer.ok) throw new Error(await answer.text());
    return answer[kind]();
  }
}
