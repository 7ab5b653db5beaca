// A bus for foreign CANopen stacks: frames to and from socketcand.
import { EventEmitter } from 'node:events';
import net from 'node:net';

/** Emits 'frame' ({ id, extended, time, data }), 'error' and 'close'. */
export class SocketcandBus extends EventEmitter {
  #socket;
  #text = '';
  #answers = [];  // who waits for a word that is not a frame

  /** Resolves when every frame of the bus arrives here. */
  static async connect(host, port, bus) {
    const self = new SocketcandBus();
    const hi = self.#answer();
    self.#socket = net.connect({ host, port: Number(port), noDelay: true });
    self.#socket.on('data', (bytes) => self.#read(bytes));
    self.#socket.on('error', (error) => self.#fail(error));
    self.#socket.on('close', () => self.#fail(new Error('the socketcand server closed the connection')));
    await hi;
    for (const command of [`< open ${bus} >`, '< rawmode >']) {
      const ok = self.#answer();
      self.#socket.write(command);
      await ok;
    }
    return self;
  }

  send({ id, data }) {
    const bytes = [...data].map((byte) => byte.toString(16)).join(' ');
    const identifier = id > 0x7FF ? id.toString(16).padStart(8, '0') : id.toString(16);
    this.#socket.write(`< send ${identifier} ${data.length} ${bytes} >`);
  }

  /** Resolves when everything sent has left this process. */
  close() {
    this.#socket.removeAllListeners('close');
    return new Promise((resolve) => { this.#socket.end(resolve); });
  }

  #answer() {
    return new Promise((resolve, reject) => this.#answers.push({ resolve, reject }));
  }

  #fail(error) {
    for (const { reject } of this.#answers.splice(0)) reject(error);
    if (this.listenerCount('error') > 0) this.emit('error', error);
  }

  #read(bytes) {
    this.#text += bytes.toString('latin1');
    for (let end; (end = this.#text.indexOf('>')) >= 0;) {
      const words = this.#text.slice(0, end + 1).trim().split(' ');
      this.#text = this.#text.slice(end + 1);
      if (words[1] === 'frame') {
        this.emit('frame', {
          id: parseInt(words[2], 16), extended: words[2].length === 8, time: Number(words[3]), data: Buffer.from(words[4], 'hex'),
        });
      } else if (words[1] === 'hi' || words[1] === 'ok') {
        this.#answers.shift()?.resolve();
      } else {
        this.#fail(new Error(words.join(' ')));
      }
    }
  }
}
