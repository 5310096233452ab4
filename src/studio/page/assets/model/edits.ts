// SPDX-License-Identifier: Apache-2.0
import {Lost, Refused} from './connection';
import type {Change, State} from './contract';

export interface Edit {
  changes: Change[];
  merge: string|null;
}

export interface Unsent {
  edit: Edit;
  before: string;  // the text that it was made upon
}

// What an Edits needs of its surroundings.
export interface EditsHost {
  // Sends one edit and does what must be done before the next is sent, such as showing its picture.
  send(edit: Edit): Promise<State>;
  text(): string;
  done(state: State): void;
  refused(line: string): void;
  pending(count: number): void;
}

const sameTarget = (a: Change, b: Change) =>
    'set' in a && 'set' in b && JSON.stringify(a.set) === JSON.stringify(b.set);
const isRepeatable = (edit: Edit) => edit.changes.every((change) => 'set' in change);

// Edits on their way to the server: one at a time, in order, none lost. Of those of one drag that wait only the last is
// kept.
export class Edits {
  private waiting: Edit[] = [];
  private sent: Unsent|null = null;
  private isStopped = true;
  private idleListeners: (() => void)[] = [];

  constructor(private host: EditsHost) {}

  add(edit: Edit): void {
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
  // again if the text is still the one before it, or if doing it twice is doing it once.
  stop(): void {
    this.isStopped = true;
  }

  resume(): void {
    this.isStopped = false;
    const {sent} = this;
    this.sent = null;
    if (sent && (sent.before === this.host.text() || isRepeatable(sent.edit))) this.waiting.unshift(sent.edit);
    this.count();
    this.next();
  }

  // For a page that ends, and for the one that follows it.
  unsent(): Unsent[] {
    const before = this.host.text();
    return [...(this.sent ? [this.sent] : []), ...this.waiting.map((edit) => ({edit, before}))];
  }

  restore(all: Unsent[]): void {
    const text = this.host.text();
    for (const [k, one] of all.entries())
      if (k > 0 || one.before === text || isRepeatable(one.edit)) this.waiting.push(one.edit);
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
    const sent = {edit, before: this.host.text()};
    this.sent = sent;
    try {
      const state = await this.host.send(edit);
      if (this.sent === sent) this.sent = null;
      this.host.done(state);
    } catch (error) {
      if (error instanceof Lost) return;  // resume() goes on with it
      if (this.sent === sent) this.sent = null;
      if (!(error instanceof Refused)) throw error;
      this.host.refused(error.message);
    }
    this.count();
    this.next();
  }
}
