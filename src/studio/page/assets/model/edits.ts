// SPDX-License-Identifier: Apache-2.0
import {Lost, Refused} from './connection';
import type {Change, State} from './contract';

export interface Edit {
  changes: Change[];
  merge: string|null;
}

// The first of them was made upon a text, each other one upon the text that the one before it gives.
export interface Unsent {
  upon: string;  // its SHA-256
  edits: Edit[];
}

// What an Edits needs of its surroundings.
export interface EditsHost {
  // Sends one edit and does what must be done before the next is sent, such as showing its picture. Null: the text is
  // another one by now, and nothing was done.
  send(edit: Edit, upon: string): Promise<State|null>;
  upon(): string;  // the SHA-256 of the text on the page
  done(state: State): void;
  dropped(count: number): void;
  refused(line: string): void;
  pending(count: number): void;
}

const sameTarget = (a: Change, b: Change) =>
    'set' in a && 'set' in b && JSON.stringify(a.set) === JSON.stringify(b.set);
const isRepeatable = (edit: Edit) => edit.changes.every((change) => 'set' in change);

// Edits on their way to the server: one at a time, in order, none lost. Of those of one drag that wait only the last is
// kept. They name tables by their places, so each is done upon the text that it was made upon, or not at all.
export class Edits {
  private waiting: Edit[] = [];
  private sent: Edit|null = null;
  private upon = '';  // that of the first of them
  private isStopped = true;
  private idleListeners: (() => void)[] = [];

  constructor(private host: EditsHost) {}

  add(edit: Edit): void {
    if (this.isIdle) this.upon = this.host.upon();
    const last = this.waiting[this.waiting.length - 1];
    const isOfSameDrag =
        last && edit.merge !== null && last.merge === edit.merge && isRepeatable(last) && isRepeatable(edit);
    if (isOfSameDrag) {
      Object.assign(last, edit, {
        changes: [...last.changes.filter((old) => !edit.changes.some((one) => sameTarget(one, old))), ...edit.changes]
      });
    } else {
      this.waiting.push({...edit});
    }
    this.count();
    this.next();
  }

  // When all that was added is answered.
  whenIdle(): Promise<void> {
    return this.isIdle ? Promise.resolve() : new Promise((done) => this.idleListeners.push(done));
  }

  get isIdle(): boolean {
    return !this.sent && this.waiting.length === 0;
  }

  // Waits, as when the connection is lost, and goes on. What was sent without an answer may have been done: it is sent
  // again, and the server does not do it twice.
  stop(): void {
    this.isStopped = true;
  }

  resume(): void {
    this.isStopped = false;
    const {sent} = this;
    this.sent = null;
    if (sent) this.waiting.unshift(sent);
    this.count();
    this.next();
  }

  // For a page that ends, and for the one that follows it.
  unsent(): Unsent {
    return {upon: this.upon, edits: [...(this.sent ? [this.sent] : []), ...this.waiting]};
  }

  restore({upon, edits}: Unsent): void {
    if (this.isIdle) this.upon = upon;
    this.waiting.push(...edits);
    this.count();
    this.next();
  }

  private count(): void {
    this.host.pending(this.waiting.length + (this.sent ? 1 : 0));
    if (this.isIdle)
      for (const done of this.idleListeners.splice(0)) done();
  }

  private async next(): Promise<void> {
    if (this.isStopped || this.sent || !this.waiting.length) return;
    const edit = this.waiting.shift()!;
    this.sent = edit;
    try {
      const state = await this.host.send(edit, this.upon);
      if (this.sent === edit) this.sent = null;
      if (state) {
        this.upon = state.sha256;
        this.host.done(state);
      } else {
        this.host.dropped(1 + this.waiting.splice(0).length);
      }
    } catch (error) {
      if (error instanceof Lost) return;  // resume() goes on with it
      if (this.sent === edit) this.sent = null;
      if (!(error instanceof Refused)) throw error;
      this.host.refused(error.message);
    }
    this.count();
    this.next();
  }
}
