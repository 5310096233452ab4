// SPDX-License-Identifier: Apache-2.0
import type {Picture, ServerEvent} from './contract';

// The server could not do what was asked; the message is its line.
export class Refused extends Error {}
// The connection ended before the answer came: whether it was done is not known.
export class Lost extends Error {}

const FIRST_RETRY_MS = 250;
const LAST_RETRY_MS = 2000;

interface Waiting {
  resolve: (answer: unknown) => void;
  reject: (error: Error) => void;
}

// Requests and their answers over one WebSocket, which is opened anew for as long as the page lives.
export class Connection {
  onOpen: () => void = () => {};
  onLost: () => void = () => {};
  onEvent: (event: ServerEvent) => void = () => {};
  // A finer picture than the one that was the answer.
  onPicture: (picture: Picture) => void = () => {};

  private socket: WebSocket|null = null;
  private waiting = new Map<number, Waiting>();
  private nextId = 1;
  private retryMs = FIRST_RETRY_MS;

  constructor(private address: string) {}

  begin(): void {
    const socket = new WebSocket(this.address);
    socket.binaryType = 'arraybuffer';
    socket.onopen = () => {
      this.socket = socket;
      this.retryMs = FIRST_RETRY_MS;
      this.onOpen();
    };
    socket.onmessage = (message) => this.take(message.data as string | ArrayBuffer);
    socket.onclose = () => this.lost();
  }

  // The answer's "ok"; of `frame` the picture.
  request<Answer>(what: string, more: object = {}): Promise<Answer> {
    const id = this.nextId++;
    return new Promise<Answer>((resolve, reject) => {
      if (!this.socket || this.socket.readyState !== WebSocket.OPEN) {
        reject(new Lost('no connection'));
        return;
      }
      this.waiting.set(id, {resolve: resolve as (answer: unknown) => void, reject});
      this.socket.send(JSON.stringify({id, do: what, ...more}));
    });
  }

  private lost(): void {
    this.socket = null;
    const waiting = [...this.waiting.values()];
    this.waiting.clear();
    for (const one of waiting) one.reject(new Lost('the connection ended'));
    this.onLost();
    setTimeout(() => this.begin(), this.retryMs);
    this.retryMs = Math.min(LAST_RETRY_MS, this.retryMs * 1.5);
  }

  private take(data: string|ArrayBuffer): void {
    if (typeof data !== 'string') {
      const picture = pictureOf(data);
      if (!this.settle(picture.header.id, (one) => one.resolve(picture))) this.onPicture(picture);
      return;
    }
    const message = JSON.parse(data);
    if (message.event)
      this.onEvent(message as ServerEvent);
    else
      this.settle(
          message.id, (one) => ('error' in message ? one.reject(new Refused(message.error)) : one.resolve(message.ok)));
  }

  private settle(id: number, how: (one: Waiting) => void): boolean {
    const one = this.waiting.get(id);
    this.waiting.delete(id);
    if (one) how(one);
    return one !== undefined;
  }
}

// Four bytes with the length of a JSON text, the text, and a JPEG.
function pictureOf(data: ArrayBuffer): Picture {
  const length = new DataView(data).getUint32(0, true);
  const header = JSON.parse(new TextDecoder().decode(new Uint8Array(data, 4, length)));
  return {header, jpeg: new Blob([new Uint8Array(data, 4 + length)], {type: 'image/jpeg'})};
}
