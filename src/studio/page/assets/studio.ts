// SPDX-License-Identifier: Apache-2.0
document.querySelector('airtruth-studio')!.textContent = 'airtruth studio';
