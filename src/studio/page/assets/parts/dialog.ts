// SPDX-License-Identifier: Apache-2.0
import type {Everything, Member} from '../model/store';
import {Part, button, h} from './part';

// A dialog of the browser's own, open while the store says so: it keeps the focus, and Escape closes it.
export abstract class DialogPart extends Part {
  protected abstract readonly name: NonNullable<Everything['dialog']>;
  protected abstract readonly title_: string;
  protected dialog = h('dialog', {});

  protected abstract fill(): Node[];
  protected opened(): void {}
  protected closed(): void {}

  protected build(): void {
    const close =
        button('×', () => this.dialog.close(), {class: 'close', 'aria-label': 'Close', title: 'Close (Escape)'});
    this.dialog.setAttribute('aria-label', this.title_);
    this.dialog.append(h('header', {}, h('h2', {}, this.title_), close), ...this.fill());
    this.dialog.addEventListener('close', () => {
      this.closed();
      if (this.now.dialog === this.name) this.studio.store.put({dialog: null});
    });
    // A click beside it closes it.
    this.dialog.addEventListener('pointerdown', (event) => {
      if (event.target === this.dialog) this.dialog.close();
    });
    this.append(this.dialog);
  }

  protected update(_: Set<Member>): void {
    const isOpen = this.now.dialog === this.name;
    if (isOpen && !this.dialog.open) {
      this.dialog.showModal();
      this.opened();
    } else if (!isOpen && this.dialog.open) {
      this.dialog.close();
    }
  }
}
