(* SPDX-License-Identifier: BSD-3-Clause *)
(** What the theorem says, and what it rests on: scripts/proof compares the names that are printed with axioms.txt. *)
From FclArtic Require Import Statement Witness Walk.

Definition the_theorem :
  (forall w m proof, accepts w m proof = true -> claim w m) /\
  (forall w m k i j t first witness, accepts_meeting w m k i j t first witness = true ->
     meaningful w m /\ meets w m (only_near witness) k i j t) :=
  conj accepts_sound accepts_meeting_sound.

Print Assumptions the_theorem.
