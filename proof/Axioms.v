(* SPDX-License-Identifier: BSD-3-Clause *)
(** What the theorem says, and what it rests on: scripts/proof compares the names that are printed with axioms.txt. *)
From FclArtic Require Import Statement Walk.

Definition the_theorem : forall w m proof, accepts w m proof = true -> claim w m := accepts_sound.

Print Assumptions the_theorem.
